// Any text as a scenario: refused with places, or read.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/text/plain_text.h"
#include "tests/tools/scenario/small_rig.h"
#include "tools/scenario/scenario_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  static const Rig rig = scenario::small_rig();
  const auto read = scenario::parse_scenario({reinterpret_cast<const char*>(data), size}, "fuzz.toml", rig);
  if (read) {
    for (const scenario::Event& event : read->events)
      if (event.after && *event.after >= read->events.size()) std::abort();
  } else {
    for (const Problem& problem : read.error())
      if (problem.what.empty() || problem.mend.empty() || !is_plain_text(problem.text()) || problem.column < 0)
        std::abort();
  }
  return 0;
}
