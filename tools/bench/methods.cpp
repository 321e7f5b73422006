#include "tools/bench/measured.h"

namespace luxrig {
namespace {

constexpr Method kMethods[] = {
    {"direct", make_direct_evaluator, false, 0},
    {"path", make_path_evaluator, true, 0.002},
    {"gather", make_gather_evaluator, true, 0.005},
};

}  // namespace

std::span<const Method> methods() { return kMethods; }

}  // namespace luxrig
