#pragma once
/// What daemon and guardian call the same by the same words.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/registry.h"

namespace luxrig {

inline constexpr const char* kGuardianName = "luxrig-guardian";
inline constexpr const char* kLookOption = "--look-fd";
inline constexpr const char* kAliveOption = "--alive-fd";
inline constexpr const char* kPidOption = "--pid-file";
inline constexpr const char* kRedirectOption = "--redirect";

/// "bus=host:port", or "bus=/path" of a serial line.
[[nodiscard]] std::string redirect_text(const std::string& bus, const Redirect& to);
[[nodiscard]] std::optional<std::pair<std::string, Redirect>> redirect_of(const std::string& text);

/// Where a guardian may say which process it is: in the state folder, or where that cannot be written, among what lives
/// as long as a process.
[[nodiscard]] std::vector<std::filesystem::path> guardian_pid_files(const std::filesystem::path& state_folder);

}  // namespace luxrig
