// Which compiled kernels this processor can run.
#pragma once

#include "engine.hpp"

namespace tautwire {

// Return the fastest kernels, or those named by `wanted` (when not null); throw when the processor
// cannot run them.
const Backend* choose_backend(const char* wanted);

}  // namespace tautwire
