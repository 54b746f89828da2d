// Threads that do the parts of a piece of work side by side.
//
// Which thread does which part, and how many there are, makes no difference to what is computed.
// The parts of a step take 2 to 50 us, so threads wait for each other by spinning: a helper spins
// while work with helpers is in progress, whether it is given parts or not, and a little longer;
// else it sleeps. Parts are claimed: where the system has no processor for a helper, the calling
// thread does them all. So nothing waits for a helper that is not there, as in a forked process.
// Working with helpers is compared with working alone, again and again, because it is slower where
// processors are busy or share no cache.
#pragma once

#include <cstdint>

namespace tautwire {

class Team {
public:
    // `threads` counts the calling one. With `awaits_helpers` helpers do all parts but the first of
    // every piece of work, however long that takes: for tests, which could not tell else that one
    // did anything.
    explicit Team(int threads, bool awaits_helpers = false);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    int threads() const { return threads_; }  // that there are
    std::int64_t helped_parts() const { return helped_parts_; }  // done by helpers so far

    // Begin work in which parts are shared, and end it, a number of steps later.
    void begin();
    void end(int steps);

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

    bool helps_ = false;  // helpers are at hand
    bool awaits_helpers_ = false;
    int threads_ = 1;
    std::int64_t helped_parts_ = 0;
    Crew* crew_ = nullptr;  // none without helpers
    // The work in progress: when it began [s], and whether it began with helpers.
    double begun_ = 0.0;
    bool tries_helpers_ = false;
    double cost_[2] = {};    // time of a step alone and with helpers [s]; 0: not known
    double reviewed_ = 0.0;  // when the slower way was tried last [s]
};

}  // namespace tautwire
