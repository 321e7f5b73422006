#pragma once
/// Luminaires of GLDF files (gldf.io, Global Lighting Data Format 1.0). A zip archive: product.xml lists the variants
/// of the product and their emitters; ldc/ holds photometric files (EULUMDAT, IES LM-63, IES XML).

#include <optional>
#include <string>
#include <string_view>

#include "core/photometry/files/photometric_file.h"

namespace luxrig {

/// Selects a part of a file that holds several luminaires.
struct LuminairePart {
  std::optional<std::string> variant;  ///< id or name
  std::optional<std::string> emitter;  ///< id or name
};

/// The light of one part, by product.xml.
struct GldfLight {
  std::string photometry_file;     ///< name as in product.xml; it is in ldc/ of the archive
  std::optional<double> rated_lm;  ///< of the emitter; none = the photometric file's own flux applies
  std::optional<double> input_w;
  std::vector<std::string> warnings;
};

/// Reads product.xml alone. Variants that all have the same emitters need no choice. Refuses, with line and column:
/// - several different parts and no choice (lists their names)
/// - emitters of several channels, or without photometry
/// - references to missing elements
/// - photometry that is only a link
[[nodiscard]] Checked<GldfLight> parse_gldf_product(std::string_view xml, const std::string& file,
                                                    const LuminairePart& part);

/// Reads a whole .gldf file. `file` is for messages.
[[nodiscard]] Checked<PhotometricFile> read_gldf(std::string bytes, const std::string& file, const LuminairePart& part);

}  // namespace luxrig
