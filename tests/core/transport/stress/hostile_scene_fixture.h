#pragma once
/// Shared by the tests of hostile_scene.

#include "tests/core/transport/stress/hostile_scene.h"

namespace luxrig::hostile_scene_fixture {

struct Entry {
  const char* name;
  std::unique_ptr<Evaluator> (*make)(const RayScene&);
};

inline constexpr Entry kEvaluators[] = {
    {"direct", make_direct_evaluator}, {"path", make_path_evaluator}, {"gather", make_gather_evaluator}};

inline EvaluateOptions few_rays(const HostileScene& made, std::uint64_t seed, int threads) {
  EvaluateOptions options;
  options.seed = seed;
  options.threads = threads;
  options.wanted_relative_error = 0.1;
  options.max_rays = made.receivers.size() < 24 ? 1'000 : 100'000;  // many receivers take more than one round
  options.levels.assign(made.emitters.size(), 0.5);
  options.colour = seed % 3 == 0;
  return options;
}

}  // namespace luxrig::hostile_scene_fixture
