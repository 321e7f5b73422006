#pragma once
/// Headers that nearly every file includes, compiled once. Every file still includes what it uses.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "core/geometry.h"
#include "core/parallel.h"
#include "core/result.h"
