// Any bytes as the material file of an OBJ: refused with a remedy, or materials with plain names; never a crash.
#include "core/check.h"
#include "core/scene/mesh/mtl_file.h"
#include "core/text/plain_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = luxrig::parse_mtl({reinterpret_cast<const char*>(data), size}, "fuzz.mtl");
  if (!file) {
    for (const luxrig::Problem& problem : file.error())
      LUXRIG_CHECK(!problem.mend.empty() && problem.line > 0 && luxrig::is_plain_text(problem.text()), "{}",
                   problem.text());
    return 0;
  }
  for (const luxrig::MtlMaterial& material : file->materials) {
    LUXRIG_CHECK(luxrig::is_plain_text(material.name), "{}", material.name);
    LUXRIG_CHECK(!material.colour || material.colour->allFinite(), "{}", material.name);
  }
  return 0;
}
