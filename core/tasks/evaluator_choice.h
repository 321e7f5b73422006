#pragma once
/// The cheapest evaluator that meets a wanted error, and the reason for the choice.

#include <string>

#include "core/transport/evaluator.h"

namespace luxrig {

struct EvaluatorChoice {
  std::unique_ptr<Evaluator> evaluator;
  std::string reason;  ///< one clause for a person
};

/// direct   nothing reflects, or a short trial of all receivers shows less reflected light than half the wanted error
/// gather   enough receivers to share paths, and an error that its records can keep
/// path     otherwise
/// The trial (128 paths per receiver) runs only where it could save more than it costs: in dark scenes, or for a coarse
/// wanted error. Deterministic. Faults as Evaluator::evaluate.
[[nodiscard]] Result<EvaluatorChoice> choose_evaluator(const RayScene& scene, std::span<const Receiver> receivers,
                                                       std::span<const Emitter> emitters,
                                                       const EvaluateOptions& options);

}  // namespace luxrig
