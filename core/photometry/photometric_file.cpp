#include "core/photometry/photometric_file.h"

#include <utility>

#include "core/photometry/eulumdat.h"
#include "core/photometry/file_text.h"
#include "core/photometry/ies.h"

namespace luxrig {

Checked<PhotometricFile> load_photometric_file(const std::filesystem::path& path) {
  if (file_text::lower(path.extension().string()) == ".ldt") {
    Checked<EulumdatFile> file = load_eulumdat(path);
    if (!file) return tl::unexpected(std::move(file.error()));
    return PhotometricFile{make_intensity(*file), luminous_opening(*file), std::nullopt, file->lamp_sets.front().watts,
                           std::move(file->warnings)};
  }
  Checked<IesFile> file = load_ies(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  return PhotometricFile{make_intensity(*file), luminous_opening(*file), std::move(file->tilt), file->input_w,
                         std::move(file->warnings)};
}

}  // namespace luxrig
