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

// Defined by kernel.cpp, once per instruction set; TAUTWIRE_X86 comes from CMakeLists.txt. The plain
// kernels use no vector types and run everywhere.
namespace plain {
extern const Backend kBackend;
}
#ifdef TAUTWIRE_X86
namespace v4 {
extern const Backend kBackend;
}
namespace v3 {
extern const Backend kBackend;
}
namespace v2 {
extern const Backend kBackend;
}
const Backend* const kBackends[] = {&v4::kBackend, &v3::kBackend, &v2::kBackend,
                                    &plain::kBackend};  // fastest first
#else
namespace generic {
extern const Backend kBackend;
}
const Backend* const kBackends[] = {&generic::kBackend, &plain::kBackend};
#endif

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
