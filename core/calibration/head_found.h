#pragma once
/// A head that was found, as part of the value that a calibration is.

#include "core/calibration/head_fit.h"
#include "core/estimation/calibration.h"

namespace luxrig {

/// Its mount and how it turns, each with its standard error. What else the entry says stays.
void put_head(const HeadFit& fit, CalibratedFixture& fixture);

}  // namespace luxrig
