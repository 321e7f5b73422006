// Any bytes as a picture on a mesh: a reason why it is not read, or means between black and white; never a crash.
#include "core/check.h"
#include "core/scene/texture.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoded = luxrig::decode_texture({reinterpret_cast<const char*>(data), size});
  LUXRIG_CHECK((decoded.texture == nullptr) != decoded.trouble.empty(), "{}", decoded.trouble);
  if (!decoded.texture) return 0;
  const luxrig::Vec3 mean = decoded.texture->mean_over({{{0, 0}, {0.3f, 7}, {-2, 0.1f}}});
  LUXRIG_CHECK(mean.minCoeff() >= 0 && mean.maxCoeff() <= 1 + 1e-6, "{}", mean.maxCoeff());
  return 0;
}
