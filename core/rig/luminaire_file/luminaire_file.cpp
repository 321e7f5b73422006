#include "core/rig/luminaire_file/luminaire_file.h"

#include <fmt/format.h>

#include "core/photometry/files/file_text.h"
#include "core/rig/luminaire_file/tm33_file.h"
#include "core/rig/luminaire_file/xml_child.h"

namespace luxrig {

Checked<PhotometricFile> load_luminaire_file(const std::filesystem::path& path, const LuminairePart& part) {
  Checked<std::string> bytes = file_text::read_text(path, "IES, EULUMDAT, TM-33 or GLDF");
  if (!bytes) return tl::unexpected(std::move(bytes.error()));
  const std::string file = path.string();
  const auto no_use = [&](const char* key, const char* format) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, fmt::format("{} has no effect on {}", key, format), fmt::format("remove {}", key)}});
  };
  if (bytes->starts_with("PK")) return read_gldf(std::move(*bytes), file, part);
  if (is_xml(*bytes)) {
    if (part.variant) return no_use("file_variant", "a TM-33 file");
    return parse_tm33(*bytes, file, part.emitter);
  }
  if (part.variant) return no_use("file_variant", "an IES or EULUMDAT file");
  if (part.emitter) return no_use("file_emitter", "an IES or EULUMDAT file");
  return parse_photometric_text(*bytes, file, tilt_files_beside(path));
}

}  // namespace luxrig
