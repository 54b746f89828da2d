#include "processor.hpp"

#include <chrono>
#include <cstring>
#include <iterator>
#include <vector>

#if defined(_MSC_VER) && defined(_M_X64)
#define NOMINMAX  // windows.h must not define min and max
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#endif

namespace tautwire {

// Defined by kernel.cpp, once per set of kernels; CMakeLists.txt writes kernels.inc, fastest first.
// The plain kernels use no vector types and run everywhere.
#define TAUTWIRE_KERNELS(set)      \
    namespace set {                \
    extern const Backend kBackend; \
    }
#include "kernels.inc"
#undef TAUTWIRE_KERNELS

const Backend* const kBackends[] = {
#define TAUTWIRE_KERNELS(set) &set::kBackend,
#include "kernels.inc"
#undef TAUTWIRE_KERNELS
};

namespace {

bool runs(const char* name) {
#if defined(_MSC_VER) && defined(_M_X64)
    // PF_..._INSTRUCTIONS_AVAILABLE, missing in old SDKs.
    constexpr DWORD kSse42 = 38, kAvx2 = 40, kAvx512 = 41;
    if (!std::strcmp(name, "v2")) return IsProcessorFeaturePresent(kSse42);
    if (!std::strcmp(name, "v4")) return IsProcessorFeaturePresent(kAvx512);
    if (!std::strcmp(name, "v3")) return IsProcessorFeaturePresent(kAvx2);
#elif defined(__x86_64__)
    __builtin_cpu_init();
    if (!std::strcmp(name, "v4"))
        return runs("v3") && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
    if (!std::strcmp(name, "v3"))
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
               __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    if (!std::strcmp(name, "v2"))
        return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
#endif
    return true;  // the kernels that need nothing special
}

}  // namespace

double seconds() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}

std::vector<const Backend*> built_backends() {
    return {std::begin(kBackends), std::end(kBackends)};
}

std::vector<const Backend*> runnable_backends() {
    std::vector<const Backend*> out;
    for (const Backend* backend : kBackends)
        if (runs(backend->name)) out.push_back(backend);
    return out;
}

}  // namespace tautwire
