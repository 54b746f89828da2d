"""What a contact force history says."""
