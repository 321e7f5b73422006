#pragma once
/// The cheapest evaluator that meets a wanted error, and why it is that one.

#include <string>

#include "core/transport/evaluator.h"

namespace luxrig {

struct EvaluatorChoice {
  std::unique_ptr<Evaluator> evaluator;
  std::string reason;  ///< one clause for a person
};

/// direct   nothing reflects, or a short trial of all receivers shows less reflected light than the wanted error
/// gather   enough receivers to share what their paths find, and an error that its records can keep
/// path     else
/// The trial (128 paths per receiver) is made only where it could save more than it costs: in dark scenes, or where the
/// wanted error is coarse. Deterministic. Faults as Evaluator::evaluate.
[[nodiscard]] Result<EvaluatorChoice> choose_evaluator(const RayScene& scene, std::span<const Receiver> receivers,
                                                       std::span<const Emitter> emitters,
                                                       const EvaluateOptions& options);

}  // namespace luxrig
