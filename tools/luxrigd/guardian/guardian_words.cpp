#include "tools/luxrigd/guardian/guardian_words.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>

#include "tools/process/runtime_folder.h"

namespace luxrig {

std::vector<std::filesystem::path> guardian_pid_files(const std::filesystem::path& state_folder) {
  std::vector<std::filesystem::path> files = {state_folder / "guardian.pid"};
  std::error_code error;
  const std::string whole = std::filesystem::weakly_canonical(state_folder, error).string();
  if (const auto folder = runtime_folder(); folder && !error)
    files.push_back(*folder / fmt::format("guardian-{:016x}.pid", std::hash<std::string>{}(whole)));
  return files;
}

std::string redirect_text(const std::string& bus, const Redirect& to) {
  return bus + "=" + (to.path.empty() ? to.host + ":" + std::to_string(to.port) : to.path);
}

std::optional<std::pair<std::string, Redirect>> redirect_of(const std::string& text) {
  // A bus name may contain =; hosts and our paths do not.
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals + 1 == text.size()) return std::nullopt;
  const std::string bus = text.substr(0, equals), to = text.substr(equals + 1);
  if (to.front() == '/') return std::pair(bus, Redirect{"", 0, to});
  const auto colon = to.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  int port = 0;
  const char* const end = to.data() + to.size();
  const auto [stopped, error] = std::from_chars(to.data() + colon + 1, end, port);
  if (error != std::errc{} || stopped != end || port < 1 || port > 65535) return std::nullopt;
  return std::pair(bus, Redirect{to.substr(0, colon), port, {}});
}

}  // namespace luxrig
