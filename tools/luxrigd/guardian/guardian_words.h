#pragma once
/// Names and formats that the daemon and its guardian share.

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

/// "bus=host:port", or "bus=/path" for a serial line.
[[nodiscard]] std::string redirect_text(const std::string& bus, const Redirect& to);
[[nodiscard]] std::optional<std::pair<std::string, Redirect>> redirect_of(const std::string& text);

/// Files in which a guardian may write its process id: in the state folder, or, if that cannot be written, in the
/// runtime folder.
[[nodiscard]] std::vector<std::filesystem::path> guardian_pid_files(const std::filesystem::path& state_folder);

}  // namespace luxrig
