#pragma once
/// What a rig file may name as a luminaire's photometry: IES LM-63, EULUMDAT, IES TM-33 (XML) or GLDF (zip), told apart
/// by content.

#include <filesystem>

#include "core/rig/luminaire_file/gldf_file.h"

namespace luxrig {

/// Reads, parses and makes the distribution. A part that a file of one luminaire has no use for is refused.
[[nodiscard]] Checked<PhotometricFile> load_luminaire_file(const std::filesystem::path& path,
                                                           const LuminairePart& part = {});

}  // namespace luxrig
