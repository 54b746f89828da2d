#include "processor.hpp"

#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string>

#if defined(_MSC_VER) && defined(_M_X64)
#include <windows.h>
#endif

namespace tautwire {

// Defined by kernel.cpp, once per instruction set; TAUTWIRE_X86 comes from CMakeLists.txt.
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
const Backend* const kBackends[] = {&v4::kBackend, &v3::kBackend, &v2::kBackend};  // fastest first
#else
namespace generic {
extern const Backend kBackend;
}
const Backend* const kBackends[] = {&generic::kBackend};
#endif

namespace {

bool runs(const char* name) {
#if defined(_MSC_VER) && defined(_M_X64)
    constexpr DWORD kAvx2 = 40, kAvx512 = 41;  // PF_..._INSTRUCTIONS_AVAILABLE, missing in old SDKs
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

const Backend* choose_backend(const char* wanted) {
    for (const Backend* backend : kBackends)
        if ((!wanted || !*wanted || !std::strcmp(wanted, backend->name)) && runs(backend->name))
            return backend;
    throw std::runtime_error(std::string("no compiled kernels for this processor") +
                             (wanted ? std::string(" with TAUTWIRE_SIMD=") + wanted : ""));
}

}  // namespace tautwire
