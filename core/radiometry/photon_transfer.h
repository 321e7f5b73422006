#pragma once
/// Electrons per count, from the growth of noise with light.
/// Source: EMVA Standard 1288, photon transfer method; J. Janesick, Photon Transfer (2007).

#include <optional>

#include "core/radiometry/exposure_series.h"
#include "core/radiometry/sample_curve.h"

namespace luxrig {

struct PhotonTransfer {
  double electrons_per_count = 0, relative_error = 0;  ///< for linear counts; its standard error
  double full_electrons = 0;                           ///< of a full sample
  double read_noise_electrons = 0;
};

/// nullopt if it cannot be determined: noise below one count, or noise that does not grow with light. `curve` converts
/// samples to light.
[[nodiscard]] std::optional<PhotonTransfer> photon_transfer(const SampleGroups& groups, int full_scale_counts,
                                                            const SampleCurve& curve);

}  // namespace luxrig
