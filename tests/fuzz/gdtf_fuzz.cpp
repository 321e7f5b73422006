// Any bytes as the description.xml of a GDTF file: never a crash; modes that keep their promises, or problems that can
// be shown to a person.
#include <cstdint>

#include "core/rig/personality/gdtf/gdtf_file.h"
#include "tests/fuzz/personality_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  luxrig::fuzz::check_personality(luxrig::parse_gdtf_description(text, "fuzz.xml"));
  return 0;
}
