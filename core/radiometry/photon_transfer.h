#pragma once
/// Electrons per count, from how noise grows with light.
/// Source: EMVA Standard 1288, photon transfer method; J. Janesick, Photon Transfer (2007).

#include <optional>

#include "core/radiometry/exposure_series.h"
#include "core/radiometry/sample_curve.h"

namespace luxrig {

struct PhotonTransfer {
  double electrons_per_count = 0, relative_error = 0;  ///< of linear counts; its standard error
  double full_electrons = 0;                           ///< of a full sample
  double read_noise_electrons = 0;
};

/// Nothing when it cannot be told: noise smaller than a count, or noise that does not grow with light. `curve` makes
/// light of samples.
[[nodiscard]] std::optional<PhotonTransfer> photon_transfer(const SampleGroups& groups, int full_scale_counts,
                                                            const SampleCurve& curve);

}  // namespace luxrig
