// Any bytes as the state of a daemon: never a throw, a blackout written out in full is never lost, and an accepted
// state is written and read back the same.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/check.h"
#include "tools/luxrigd/state/journal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const luxrig::LegibleState read = luxrig::legible_state_of(text);

  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_object() && json.contains("blackout") && json["blackout"].is_boolean()) {
    LUXRIG_CHECK(read.state.blackout == json["blackout"].get<bool>(), "another blackout than {}", text);
  } else {
    const bool says_dark = text.find("\"blackout\": true") != std::string::npos;
    LUXRIG_CHECK(read.state.blackout || !says_dark, "lit again: {}", text);
    LUXRIG_CHECK(!read.damage.empty(), "taken for whole: {}", text);
  }

  const std::string written = luxrig::state_text(read.state);
  const luxrig::LegibleState again = luxrig::legible_state_of(written);
  LUXRIG_CHECK(again.damage.empty(), "own text is damaged ({}): {}", again.damage, written);
  LUXRIG_CHECK(luxrig::state_text(again.state) == written, "not the same when written again: {}", written);
  // Cut anywhere after the blackout, as by a failing disk.
  if (read.state.blackout) {
    const std::size_t seen = written.find("\"blackout\": true") + sizeof("\"blackout\": true") - 1;
    const std::size_t cut = seen + size % (written.size() - seen + 1);
    LUXRIG_CHECK(luxrig::legible_state_of(written.substr(0, cut)).state.blackout, "lit again when cut at {}", cut);
  }
  return 0;
}
