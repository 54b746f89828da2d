"""Song, Ronnquist, Navik (2021): the high-frequency programme, figure by figure, with verdicts."""
