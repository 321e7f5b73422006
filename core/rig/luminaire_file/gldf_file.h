#pragma once
/// Luminaires of GLDF files (gldf.io, Global Lighting Data Format 1.0): a zip archive with product.xml, which says
/// what variants the product has and which emitters those, and photometric files (EULUMDAT, IES LM-63, IES XML) in
/// ldc/.

#include <optional>
#include <string>
#include <string_view>

#include "core/photometry/photometric_file.h"

namespace luxrig {

/// Which part of a file of several luminaires is meant.
struct LuminairePart {
  std::optional<std::string> variant;  ///< id or name
  std::optional<std::string> emitter;  ///< id or name
};

/// What product.xml says of the light of one part.
struct GldfLight {
  std::string photometry_file;     ///< name as in product.xml; the archive has it in ldc/
  std::optional<double> rated_lm;  ///< of the emitter; else the photometric file's own flux holds
  std::optional<double> input_w;
  std::vector<std::string> warnings;
};

/// product.xml alone. Variants that all have the same emitters need no choice. Refuses, with line and column: no part
/// chosen where several differ (with their names), emitters of several channels or without photometry, references to
/// what is not there, photometry that is only linked to.
[[nodiscard]] Checked<GldfLight> parse_gldf_product(std::string_view xml, const std::string& file,
                                                    const LuminairePart& part);

/// A whole .gldf file. `file` is for the messages.
[[nodiscard]] Checked<PhotometricFile> read_gldf(std::string bytes, const std::string& file, const LuminairePart& part);

}  // namespace luxrig
