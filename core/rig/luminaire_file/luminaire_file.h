#pragma once
/// Photometry files that a rig may name for a luminaire: IES LM-63, EULUMDAT, IES TM-33 (XML) or GLDF (zip), told apart
/// by content.

#include <filesystem>

#include "core/rig/luminaire_file/gldf_file.h"

namespace luxrig {

/// Reads and parses the file and makes the distribution. Refuses a part if the file holds only one luminaire.
[[nodiscard]] Checked<PhotometricFile> load_luminaire_file(const std::filesystem::path& path,
                                                           const LuminairePart& part = {});

}  // namespace luxrig
