#include "team.hpp"

#include "engine.hpp"

#if TAUTWIRE_THREADS
#include <atomic>
#include <system_error>
#include <thread>
#if __has_include(<pthread.h>)
#include <pthread.h>
#include <signal.h>
#endif
#endif

namespace tautwire {

#if TAUTWIRE_THREADS

namespace {

// A wait longer than this [s] means that the system has taken a helper off its processor: a part
// takes 2 to 50 us on lines of a kilometre, and the calling thread has done one as long before it
// waits.
constexpr double kPatience = 300e-6;
// After so long [s] the way of working that seems slower, alone or with helpers, is tried again,
// for one call of the engine, which takes 2 to 10 ms: a hundredth of the time is at stake.
constexpr double kReview = 0.5;
// Steps of a call that tell how fast it was, and the part of what they tell that counts.
constexpr int kTelling = 10;
constexpr double kNew = 0.3;
// A helper that was given nothing for so long [s] sleeps if no work with helpers is in progress;
// if there is, it offers its processor to other threads and spins on. Between two calls of the
// engine pass 0.1 to 0.3 ms, in which it should not fall asleep; the engines of an extrapolated
// passage work in turn, and the helper of the one that rests should.
constexpr double kIdle = 0.5e-3;
// Turns of a waiting loop between two looks at the clock, about 1 us. No instruction that tells the
// processor of the waiting: on virtual machines thousands of them hand it over to the host, and
// parts then take twice as long.
constexpr int kTurns = 256;

// Signals are for the thread that runs Python.
class SignalsBlocked {
#if __has_include(<pthread.h>)
public:
    SignalsBlocked() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t before_;
#endif
};

}  // namespace

// What the threads of a team share. No lock: a process forked at any instant goes on without helpers.
struct Team::Crew {
    static constexpr std::uint64_t kOver = ~std::uint64_t{0};

    // Number of the piece of work, count of its parts, and the next part that nobody has claimed.
    alignas(64) std::atomic<std::uint64_t> offer{0};
    alignas(64) std::atomic<int> done{0};  // parts done by helpers
    alignas(64) Work work = nullptr;
    const void* what = nullptr;
    std::atomic<int> owners{1};  // the team and its helpers; the last one deletes
    std::atomic<int> is_awake{0};

    // Claim a part of the present offer, or return -1.
    int claim() {
        std::uint64_t now = offer.load(std::memory_order_acquire);
        while (now != kOver && (now & 255) < (now >> 8 & 255))
            if (offer.compare_exchange_weak(now, now + 1, std::memory_order_acq_rel,
                                            std::memory_order_acquire))
                return static_cast<int>(now & 255);
        return -1;
    }
    bool is_over() const { return offer.load(std::memory_order_acquire) == kOver; }

    void help() {
        while (!is_over()) {
            is_awake.wait(0, std::memory_order_acquire);
            for (double idle_since = seconds(); seconds() - idle_since < kIdle;)
                if (helped()) idle_since = seconds();
            if (is_awake.load(std::memory_order_relaxed)) std::this_thread::yield();
        }
        leave();
    }
    // Whether there was a part to do in a number of turns.
    bool helped() {
        for (int n = 0; n < kTurns; ++n) {
            const int part = claim();
            if (part < 0) continue;
            work(what, part);
            done.fetch_add(1, std::memory_order_release);
            return true;
        }
        return false;
    }
    void leave() {
        if (owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete this;
    }
    void wake() {
        is_awake.store(1, std::memory_order_release);
        is_awake.notify_all();
    }
};

Team::Team(int threads, bool awaits_helpers) : awaits_helpers_(awaits_helpers) {
    if (threads < 2) return;
    crew_ = new Crew;
    const SignalsBlocked blocked;
    for (int n = 1; n < threads; ++n) {
        crew_->owners.fetch_add(1);
        try {
            std::thread([crew = crew_] { crew->help(); }).detach();
            ++threads_;
        } catch (const std::system_error&) {  // no more threads; those that there are do the work
            crew_->leave();
        }
    }
    if (threads_ > 1) return;
    crew_->leave();
    crew_ = nullptr;
}

Team::~Team() {
    if (!crew_) return;
    crew_->offer.store(Crew::kOver, std::memory_order_release);
    crew_->wake();
    crew_->leave();
}

void Team::begin() {
    if (!crew_) return;
    begun_ = seconds();
    // Helpers first; then alone, to compare.
    tries_helpers_ = cost_[1] == 0.0 || (cost_[0] != 0.0 && cost_[1] < cost_[0]);
    if (cost_[0] != 0.0 && begun_ - reviewed_ > kReview) {
        tries_helpers_ = !tries_helpers_;
        reviewed_ = begun_;
    }
    if (awaits_helpers_) tries_helpers_ = true;
    helps_ = tries_helpers_;
    if (helps_) crew_->wake();
}

void Team::end(int steps) {
    if (!crew_) return;
    helps_ = false;
    crew_->is_awake.store(0, std::memory_order_relaxed);
    if (steps < kTelling) return;
    const double now = (seconds() - begun_) / steps;
    double& cost = cost_[tries_helpers_];
    cost = cost == 0.0 ? now : cost + kNew * (now - cost);
}

void Team::share(int parts, Work work, const void* what) {
    Crew& crew = *crew_;
    crew.done.store(0, std::memory_order_relaxed);
    crew.work = work;
    crew.what = what;
    const std::uint64_t number = (crew.offer.load(std::memory_order_relaxed) >> 16) + 1;
    crew.offer.store(number << 16 | static_cast<std::uint64_t>(parts) << 8 | 1,
                     std::memory_order_release);
    int own = 1;
    work(what, 0);
    for (int part; !awaits_helpers_ && (part = crew.claim()) >= 0; ++own) work(what, part);
    double since = 0.0;
    for (unsigned n = 1; crew.done.load(std::memory_order_acquire) < parts - own; ++n) {
        if (n % kTurns) continue;
        const double now = seconds();
        if (since == 0.0) since = now;
        if (now - since < kPatience) continue;
        helps_ = awaits_helpers_;   // if not, until the end of this call
        std::this_thread::yield();  // the helper may be waiting for this very processor
    }
    helped_parts_ += parts - own;
}

#else  // a system without threads

struct Team::Crew {};
Team::Team(int, bool) {}
Team::~Team() = default;
void Team::begin() {}
void Team::end(int) {}
void Team::share(int parts, Work work, const void* what) {
    for (int part = 0; part < parts; ++part) work(what, part);
}

#endif

}  // namespace tautwire
