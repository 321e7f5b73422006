#pragma once
/// Shared by the tests of indirect_candidates.

#include "core/transport/candidates/candidate_transport.h"

namespace luxrig::indirect_candidates_fixture {

inline CandidateOptions coarse() {
  CandidateOptions options;
  options.surface_cells = 2000;
  options.max_rays_per_candidate = 512;
  return options;
}

}  // namespace luxrig::indirect_candidates_fixture
