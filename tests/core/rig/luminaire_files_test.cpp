// GLDF and TM-33 files: the selected part, the flux it states, and refusals that list the parts of the file.
#include <gtest/gtest.h>
#include <zip.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/rig/luminaire_file/luminaire_file.h"
#include "core/rig/luminaire_file/tm33_file.h"
#include "core/rig/rig_file.h"
#include "tests/folders.h"
#include "tests/mutants.h"

namespace luxrig {
namespace {

std::filesystem::path luminaire_data() { return test::source_folder() / "tests/data/luminaires"; }

std::string luminaire_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {(std::istreambuf_iterator<char>(in)), {}};
}

std::string refusal_of(const Checked<PhotometricFile>& file) { return file ? "read" : file.error().front().text(); }

double flux_lm(const Checked<PhotometricFile>& file) { return file ? file->intensity->flux_lm() : -1; }

/// Intensity towards nadir over that at 45°.
double narrowness(const Checked<PhotometricFile>& file) {
  return file->intensity->intensity_cd(-Vec3::UnitZ()) /
         file->intensity->intensity_cd(Vec3(std::sqrt(0.5), 0, -std::sqrt(0.5)));
}

TEST(GldfFiles, GiveTheLightOfTheChosenVariantAndEmitter) {
  const auto path = luminaire_data() / "two_heads.gldf";
  const auto down = load_luminaire_file(path, {"v10", "direct10"});
  ASSERT_TRUE(down.has_value()) << refusal_of(down);
  EXPECT_NEAR(flux_lm(down), 1200, 1e-9);
  EXPECT_DOUBLE_EQ(down->input_w, 10);
  EXPECT_NEAR(narrowness(down), 330 / (330 * 0.7071), 1e-4);
  const auto by_name = load_luminaire_file(path, {"Pendant 15 W", "down"});
  ASSERT_TRUE(by_name.has_value()) << refusal_of(by_name);
  EXPECT_NEAR(flux_lm(by_name), 1800, 1e-9) << "not the 50 lm of its emergency light";
  EXPECT_DOUBLE_EQ(by_name->input_w, 15);
  const auto up = load_luminaire_file(path, {"v10", "up"});
  ASSERT_TRUE(up.has_value()) << refusal_of(up);
  EXPECT_NEAR(flux_lm(up), 600, 1e-9);
  EXPECT_NEAR(narrowness(up), 200 / (180 + 0.25 * 20), 0.03);  // the IES file
}

TEST(GldfFiles, AreRefusedWithTheirNamesWithoutAChoice) {
  const auto path = luminaire_data() / "two_heads.gldf";
  const std::string variants = refusal_of(load_luminaire_file(path));
  EXPECT_NE(variants.find(R"(product.xml:48:6: the file has 3 variants: "v10" ("Pendant 10 W"), "v15")"),
            std::string::npos)
      << variants;
  EXPECT_NE(variants.find("write file_variant ="), std::string::npos) << variants;
  const std::string emitters = refusal_of(load_luminaire_file(path, {"v10", {}}));
  EXPECT_NE(emitters.find(R"(2 emitters: "direct10" ("down"), "indirect" ("up"))"), std::string::npos) << emitters;
  EXPECT_NE(refusal_of(load_luminaire_file(path, {"v11", {}})).find(R"(no variant is called "v11")"),
            std::string::npos);
  const std::string linked = refusal_of(load_luminaire_file(path, {"web", {}}));
  EXPECT_NE(linked.find("not in the file, but at \"https://example.org/far.ies\""), std::string::npos) << linked;
}

TEST(GldfFiles, NeedNoChoiceBetweenEqualVariants) {
  const auto file = load_luminaire_file(luminaire_data() / "colours.gldf");
  ASSERT_TRUE(file.has_value()) << refusal_of(file);
  EXPECT_NEAR(flux_lm(file), 1800, 1e-9);
}

TEST(Tm33Files, GiveTheirIntensitiesInCandela) {
  const auto file = load_luminaire_file(luminaire_data() / "tm33_18.xml");
  ASSERT_TRUE(file.has_value()) << refusal_of(file);
  // 100 cd · cos γ · (1 + 0.2 cos C) in steps of 15° and 90°, linear between.
  EXPECT_NEAR(file->intensity->intensity_cd(-Vec3::UnitZ()), 120, 1e-9);
  EXPECT_NEAR(file->intensity->intensity_cd(Vec3(std::sqrt(0.75), 0, -0.5)), 60, 1e-9);
  EXPECT_NEAR(file->intensity->intensity_cd(Vec3(-std::sqrt(0.75), 0, -0.5)), 40, 1e-9);
  EXPECT_NEAR(flux_lm(file), 100 * kPi, 3);
  EXPECT_DOUBLE_EQ(file->input_w, 4);
  EXPECT_TRUE(file->warnings.empty());
}

TEST(Tm33Files, NeedAChoiceBetweenSeveralEmitters) {
  const auto path = luminaire_data() / "tm33_23.xml";
  const std::string refused = refusal_of(load_luminaire_file(path));
  EXPECT_NE(refused.find(R"(tm33_23.xml:2:2: the file has 2 emitters: "down" ("main light"), "glow" ("night light"))"),
            std::string::npos)
      << refused;
  const auto glow = load_luminaire_file(path, {{}, "glow"});
  ASSERT_TRUE(glow.has_value()) << refusal_of(glow);
  EXPECT_NEAR(flux_lm(glow), 10 * kPi, 0.3);
  EXPECT_NE(glow->warnings.back().find("RatedLumens says 1000 lm"), std::string::npos);
  EXPECT_NEAR(flux_lm(load_luminaire_file(path, {{}, "main light"})), 320 * kPi, 10) << "times its Multiplier";
  EXPECT_NE(refusal_of(load_luminaire_file(path, {{}, "marker"})).find("no emitter is called"), std::string::npos);
}

TEST(Tm33Files, ReportErrorsWithTheirLine) {
  const std::string good = luminaire_text(luminaire_data() / "tm33_18.xml");
  const auto changed = [&](std::string_view from, std::string_view to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal_of(parse_tm33(text, "f.xml", std::nullopt));
  };
  const std::string value = R"(<IntensityData horz="0" vert="15">115.911</IntensityData>)";
  ASSERT_NE(good.find(value), std::string::npos);
  EXPECT_EQ(changed(value, "").substr(0, 44), "f.xml:8:6: no intensity at horz 0, vert 15: ");
  EXPECT_NE(changed("vert=\"15\"", "vert=\"30\"").find("f.xml:11:8: a second intensity at horz 0, vert 30"),
            std::string::npos);
  EXPECT_NE(changed("115.911", "115,911").find("f.xml:10:8: intensity \"115,911\" is not a number"), std::string::npos);
  EXPECT_NE(changed("vert=\"15\"", "vert=\"1O\"").find("f.xml:10:8: vert \"1O\" is no angle"), std::string::npos);
  EXPECT_NE(changed("<Quantity>", "<Metric>Radiant</Metric><Quantity>").find("not candela"), std::string::npos);
  EXPECT_NE(changed("</IntensityDistribution>", "").find("not well-formed"), std::string::npos);
  EXPECT_NE(refusal_of(parse_tm33("<Root/>", "f.xml", {})).find("f.xml:1:2: root element \"Root\""), std::string::npos);
  EXPECT_EQ(changed("<Quantity>1<", "<Quantity>2<"), "read");
}

TEST(Tm33Files, AreReadInUtf16) {
  std::string wide = "\xFF\xFE";
  for (const char c : luminaire_text(luminaire_data() / "tm33_18.xml")) wide += {c, '\0'};
  const auto file = parse_tm33(wide, "f.xml", std::nullopt);
  ASSERT_TRUE(file.has_value()) << refusal_of(file);
  EXPECT_NEAR(flux_lm(file), 100 * kPi, 3);
}

TEST(LuminaireFiles, LoadAsLuminairesOfARig) {
  const auto rig = [](const std::string& keys) {
    return parse_rig("[rig]\nname = \"r\"\n[[luminaire]]\nname = \"l\"\nmodel = \"ies\"\n" + keys, "rig.toml",
                     luminaire_data());
  };
  const auto gldf = rig("file = \"two_heads.gldf\"\nfile_variant = \"v15\"\nfile_emitter = \"up\"\n");
  ASSERT_TRUE(gldf.has_value()) << gldf.error().front().text();
  EXPECT_NEAR(gldf->luminaires[0].lumens, 600, 1e-9);
  EXPECT_NEAR(rig("file = \"tm33_18.xml\"\n")->luminaires[0].lumens, 100 * kPi, 3);
  const auto useless = rig("file = \"tm33_18.xml\"\nfile_variant = \"v\"\n");
  ASSERT_FALSE(useless.has_value());
  EXPECT_NE(useless.error().back().what.find("file_variant has no effect"), std::string::npos);
}

/// The archive with its product.xml replaced.
std::string repacked(const std::string& product, const std::string& ldt) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* to = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_t* zip = zip_open_from_source(to, ZIP_TRUNCATE, &error);
  zip_source_keep(to);
  zip_file_add(zip, "product.xml", zip_source_buffer(zip, product.data(), product.size(), 0), 0);
  zip_file_add(zip, "ldc/narrow.ldt", zip_source_buffer(zip, ldt.data(), ldt.size(), 0), 0);
  zip_close(zip);
  zip_source_open(to);
  zip_stat_t stat;
  zip_source_stat(to, &stat);
  std::string bytes(stat.size, '\0');
  zip_source_read(to, bytes.data(), bytes.size());
  zip_source_close(to);
  zip_source_free(to);
  return bytes;
}

void expect_read_or_refused(const Checked<PhotometricFile>& file, int i) {
  if (file) {
    ASSERT_TRUE(std::isfinite(file->intensity->flux_lm()) && file->intensity->flux_lm() > 0) << i;
    return;
  }
  ASSERT_FALSE(file.error().empty()) << i;
  for (const Problem& problem : file.error()) ASSERT_FALSE(problem.what.empty() || problem.mend.empty()) << i;
}

TEST(LuminaireMutants, OfTm33AreReadOrRefused) {
  const std::string whole = luminaire_text(luminaire_data() / "tm33_18.xml");
  Random random(33);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto file = parse_tm33(mutant_of(whole, random), "f.xml", std::nullopt);
    expect_read_or_refused(file, i);
    read += file.has_value();
    if (!file) {
      for (const Problem& problem : file.error()) ASSERT_GT(problem.line, 0) << problem.text();
    }
  }
  EXPECT_GT(read, 100);
}

TEST(LuminaireMutants, OfGldfAreReadOrRefused) {
  const std::string product = luminaire_text(test::source_folder() / "tests/fuzz/corpus/gldf/colours");
  const std::string archive = luminaire_text(luminaire_data() / "colours.gldf");
  std::ostringstream ldt;
  ldt << "x\n1\n1\n1\n0\n2\n90\nr\nn\n1\nf\nd\n1\n1\n1\n1\n1\n0\n0\n0\n0\n100\n100\n1\n0\n1\n-1\nL\n1000\n3\n9\n1\n";
  for (int i = 0; i < 10; ++i) ldt << "0.5\n";
  ldt << "0\n0\n90\n330\n0\n";
  Random random(34);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    expect_read_or_refused(read_gldf(mutant_of(archive, random), "f.gldf", {}), i);
    const auto file = read_gldf(repacked(mutant_of(product, random), ldt.str()), "f.gldf", {});
    expect_read_or_refused(file, i);
    read += file.has_value();
  }
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace luxrig
