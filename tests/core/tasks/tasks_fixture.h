#pragma once
/// Shared by the tests of tasks.

#include <fstream>
#include <sstream>

#include "tests/core/tasks/opened_rigs.h"

namespace luxrig::tasks_fixture {

inline constexpr const char* kLevels = "[[task]]\nname = \"levels\"\nkind = \"emittance\"\n";

inline std::filesystem::path room_folder() { return test::source_folder() / "tests/rigs/room"; }

inline std::string room_text() {
  std::ifstream in(room_folder() / "rig.toml");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

inline Session opened(const std::string& text) { return opened_rig(text, room_folder()); }

/// Two bulbs somewhere under the ceiling, in place of the tasks of the room.
inline std::string room_with_places() {
  return replaced(room_text(), kLevels,
                  "[mounting]\nsurfaces = [\"ceiling\"]\noffset_m = [0.1, 0.3]\n\n"
                  "[[task]]\nname = \"bulbs\"\nkind = \"placement\"\nluminaire = \"bulb\"\nlights = 2\n"
                  "fixtures = \"off\"\nseconds = 60\n");
}

}  // namespace luxrig::tasks_fixture
