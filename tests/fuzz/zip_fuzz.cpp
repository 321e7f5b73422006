// Any bytes as the zip archive of a GDTF or MVR file: entries stay within their bounds, or are refused.
#include <cstdint>

#include "core/rig/personality/gdtf/gdtf_file.h"
#include "core/rig/personality/zip_archive.h"
#include "tests/fuzz/personality_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMax = 1 << 20;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const auto archive = luxrig::ZipArchive::open(bytes, "fuzz.zip");
  if (!archive) {
    luxrig::fuzz::check_problems(archive.error());
    return 0;
  }
  for (std::size_t i = 0; i < archive->names().size() && i < 8; ++i) {
    const auto content = archive->read(archive->names()[i], kMax);
    if (content) {
      LUXRIG_CHECK(content->size() <= kMax, "{} bytes", content->size());
    } else {
      luxrig::fuzz::check_problems(content.error());
    }
  }
  luxrig::fuzz::check_personality(luxrig::read_gdtf(bytes, "fuzz.gdtf"));
  return 0;
}
