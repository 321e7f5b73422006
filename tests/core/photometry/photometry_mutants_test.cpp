// 3,000 damaged copies of real files for each reader. Each is refused with a line number or gives a valid distribution.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/photometry/files/photometric_file.h"
#include "tests/core/photometry/photometric_data.h"
#include "tests/mutants.h"

namespace luxrig {
namespace {

class PhotometryMutants : public testing::TestWithParam<const char*> {};

TEST_P(PhotometryMutants, AreReadOrRefusedWithALine) {
  std::ifstream in(data_file(GetParam()), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  ASSERT_FALSE(whole.empty());
  Random random(20);
  int read = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto file = parse_photometric_text(mutant_of(whole, random), GetParam());
    if (!file) {
      ASSERT_FALSE(file.error().empty()) << i;
      for (const Problem& problem : file.error()) {
        ASSERT_GT(problem.line, 0) << i << ": " << problem.text();
        ASSERT_FALSE(problem.mend.empty()) << i;
      }
      continue;
    }
    ++read;
    const double flux_lm = file->intensity->flux_lm();
    ASSERT_TRUE(std::isfinite(flux_lm) && flux_lm > 0) << i;
    for (double gamma_deg = 0; gamma_deg <= 180; gamma_deg += 15) {
      const double cd = file->intensity->intensity_cd(direction(gamma_deg, 37));
      ASSERT_TRUE(std::isfinite(cd) && cd >= 0 && cd <= file->intensity->max_intensity_cd() * (1 + 1e-9)) << i;
    }
  }
  EXPECT_GT(read, 50) << "the mutants are too wild to try more than the first check";
}

INSTANTIATE_TEST_SUITE_P(All, PhotometryMutants,
                         testing::Values("007cfb11e343e2f42e3b476be4ab684e.ies", "tilt_include_geometry2.ies",
                                         "sample1.ldt", "sample_05.ldt"));

}  // namespace
}  // namespace luxrig
