#pragma once
/// Options of every command that computes light.

#include <CLI/CLI.hpp>

#include "core/tasks/session.h"

namespace luxrig {

void add_compute(CLI::App& command, ComputeOptions& compute);

}  // namespace luxrig
