#pragma once
/// Luminaires of ANSI/IES TM-33 (IES XML): TM-33-18 and its twin UNI 11733 / ATLA S001 (root LuminaireOpticalData or
/// IESTM33-18), TM-33-23 (root IESTM33-22, IESTM33-23). Each <Emitter> holds <IntensityData horz="…" vert="…">candela
/// at the angles of LM-63, so it is read into an IesFile.

#include <optional>
#include <string>
#include <string_view>

#include "core/photometry/files/photometric_file.h"

namespace luxrig {

/// Reads the emitter called `emitter` (its <ID>, else its number from 1), or the only one with a distribution. Refuses,
/// with line and column:
/// - a file that is not TM-33
/// - several emitters and no choice (lists their names)
/// - data that is not luminous
/// - a grid with gaps or duplicate values
/// - angles and values that parse_ies() refuses
[[nodiscard]] Checked<PhotometricFile> parse_tm33(std::string_view text, const std::string& file,
                                                  const std::optional<std::string>& emitter);

}  // namespace luxrig
