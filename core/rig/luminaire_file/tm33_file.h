#pragma once
/// Luminaires of ANSI/IES TM-33 (IES XML): TM-33-18 and its twin UNI 11733 / ATLA S001 (root LuminaireOpticalData or
/// IESTM33-18), TM-33-23 (root IESTM33-22, IESTM33-23). Each <Emitter> holds <IntensityData horz="…" vert="…">candela
/// in angles of LM-63: what is read becomes an IesFile.

#include <optional>
#include <string>
#include <string_view>

#include "core/photometry/photometric_file.h"

namespace luxrig {

/// The emitter called `emitter` (its <ID>, else its number from 1), or the only one with a distribution. Refuses, with
/// line and column: what is no TM-33 file, more than one emitter without a choice (with their names), data that is not
/// luminous, a grid with holes or double values, and what parse_ies() refuses of angles and values.
[[nodiscard]] Checked<PhotometricFile> parse_tm33(std::string_view text, const std::string& file,
                                                  const std::optional<std::string>& emitter);

}  // namespace luxrig
