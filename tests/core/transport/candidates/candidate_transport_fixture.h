#pragma once
/// Shared by the tests of candidate_transport.

#include <gtest/gtest.h>

#include "core/transport/candidates/candidate_transport.h"

namespace luxrig::candidate_transport_fixture {

inline CandidateOptions direct_only() {
  CandidateOptions options;
  options.indirect = false;
  return options;
}

inline void expect_same_bytes(const CandidateColumns& a, const CandidateColumns& b) {
  EXPECT_EQ(a.begin, b.begin);
  EXPECT_EQ(a.receiver, b.receiver);
  EXPECT_EQ(a.direct_lux, b.direct_lux);
  EXPECT_EQ(a.total_lux, b.total_lux);
  EXPECT_EQ(a.standard_error_lux, b.standard_error_lux);
}

}  // namespace luxrig::candidate_transport_fixture
