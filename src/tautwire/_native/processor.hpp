// Which compiled kernels there are, and which of them this processor can run.
#pragma once

#include <vector>

#include "engine.hpp"

namespace tautwire {

// Fastest first; the last ones, without vector types, run on every processor.
std::vector<const Backend*> built_backends();
std::vector<const Backend*> runnable_backends();

}  // namespace tautwire
