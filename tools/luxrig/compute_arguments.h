#pragma once
/// Options of every command that computes light.

#include <CLI/CLI.hpp>

#include "core/tasks/session.h"

namespace luxrig {

/// Seed, threads and accuracy.
void add_compute(CLI::App& command, ComputeOptions& compute);
/// The same, and the model.
void add_model(CLI::App& command, ComputeOptions& compute);

}  // namespace luxrig
