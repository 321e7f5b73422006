/// Tests the evaluators that commands can reach. For a new one, add a line to kEvaluators.
#include "tests/core/transport/evaluator_conformance.h"

namespace luxrig::conformance {
namespace {

constexpr Entry kEvaluators[] = {
    {"direct", [](const Scene&, const RayScene& rays) { return make_direct_evaluator(rays); }},
    {"path", [](const Scene&, const RayScene& rays) { return make_path_evaluator(rays); }},
    {"gather", [](const Scene&, const RayScene& rays) { return make_gather_evaluator(rays); }}};

INSTANTIATE_TEST_SUITE_P(All, EvaluatorConformance, testing::ValuesIn(kEvaluators), name_of);

}  // namespace
}  // namespace luxrig::conformance
