#pragma once
/// `luxrig render PLAN --compare`: an object in the light that hangs, in a plan's, and in one key light from 45°.

#include "tools/luxrig/render/render_command.h"

namespace luxrig {

/// For `options.compare`, which needs a plan. Returns the exit code, as run_show().
int run_compare(const RenderOptions& options);

}  // namespace luxrig
