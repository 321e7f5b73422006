// Any bytes as an Open Fixture Library file: the same properties as for GDTF descriptions.
#include <cstdint>

#include "core/rig/personality/ofl/ofl_file.h"
#include "tests/fuzz/personality_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  luxrig::fuzz::check_personality(luxrig::parse_ofl(text, "maker", "fuzz.json"));
  return 0;
}
