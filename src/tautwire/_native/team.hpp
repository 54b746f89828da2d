// Threads that do the parts of a piece of work side by side.
//
// Which thread does which part, and how many there are, makes no difference to what is computed. The
// pieces of work of a step take 2 to 50 us, so threads wait for each other by spinning; a helper that
// is given nothing for a while sleeps. Parts are claimed: where the system has no processor for a
// helper, the calling thread does them all. So nothing waits for a helper that is not there, as in a
// forked process.
#pragma once

namespace tautwire {

class Team {
public:
    // `threads` counts the calling one.
    explicit Team(int threads = 1);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    int threads() const { return threads_; }
    // Begin work in which parts are shared, and end it: helpers wake up, and may sleep.
    void begin();
    void end();

    // Call work(part) for each part once; return when all have returned. Work must not throw.
    template <class F>
    void share(int parts, const F& work) {
        if (!helps_ || parts == 1) {
            for (int part = 0; part < parts; ++part) work(part);
            return;
        }
        share(parts, [](const void* what, int part) { (*static_cast<const F*>(what))(part); }, &work);
    }

private:
    using Work = void (*)(const void* what, int part);
    struct Crew;
    void share(int parts, Work work, const void* what);
    void work_alone();

    int threads_;
    bool helps_ = false;         // helpers are at hand
    Crew* crew_ = nullptr;
    // A helper that the system has taken off its processor in the middle of a part keeps all waiting.
    // Then the calling thread works alone for a while [s], until an instant.
    double rest_, rests_until_ = 0.0;
    double begun_ = 0.0, helped_ = 0.0;  // the work in progress, and how long helpers did well
};

}  // namespace tautwire
