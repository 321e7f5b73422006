#pragma once
/// From a rig file to something that can be computed with. Every command starts here.

#include <filesystem>

#include "core/tasks/session.h"

namespace luxrig {

/// Reads and checks everything: rig, its calibration if there is one, photometry, buses, meshes, mounting. All problems,
/// or a Session.
[[nodiscard]] Checked<Session> open_session(const std::filesystem::path& rig_path);

/// The same without a calibration: what the rig file says, to measure or to simulate.
[[nodiscard]] Checked<Session> open_stated_session(const std::filesystem::path& rig_path);

/// Says on stderr by which calibration a command computes, and whether it is of a simulated rig; nothing without one.
void tell_calibration(const Rig& rig);

/// A rig as its file has it, with the calibration beside it, if there is one.
[[nodiscard]] Checked<Rig> with_calibration(Rig rig);

}  // namespace luxrig
