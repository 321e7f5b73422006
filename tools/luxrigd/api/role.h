#pragma once
/// What somebody may do with the daemon.

#include <optional>
#include <string_view>

namespace luxrig {

/// Each may do what those before it may.
enum class Role {
  anybody,    ///< has no access: the page's files, and to log in
  look,       ///< reads
  operate,    ///< changes the light
  configure,  ///< changes what the rig is, or who has access
};
[[nodiscard]] const char* name_of(Role role);

/// "look", "operate" or "configure".
[[nodiscard]] std::optional<Role> role_called(std::string_view name);

}  // namespace luxrig
