#pragma once
/// Computes the transport of candidates; fails the test on error.

#include <gtest/gtest.h>

#include <utility>

#include "core/transport/candidates/candidate_transport.h"

namespace luxrig {

inline CandidateTransport computed(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                                   const CandidateSet& set, const CandidateOptions& options) {
  auto result = candidate_transport(scene, rays, receivers, set, options);
  EXPECT_TRUE(result) << result.error().detail;
  return result ? std::move(*result) : CandidateTransport{};
}

}  // namespace luxrig
