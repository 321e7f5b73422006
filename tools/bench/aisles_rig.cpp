#include "tools/bench/aisles_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr int kWorksPerWall = 25;
constexpr double kBetweenWorks_m = 1.6, kAisle_m = 5, kHeight_m = 4.5, kTrack_z_m = 3.8, kTrackFromWall_m = 1.7;

class Aisles {
 public:
  Aisles(int fixtures, int points) : fixtures_(fixtures), points_(points) {
    walls_ = std::max(1, (points + kWorksPerWall - 1) / kWorksPerWall);
    walls_ += walls_ % 2;  // an aisle has two walls
    length_m_ = kWorksPerWall * kBetweenWorks_m + 4;
  }

  std::string text() {
    out_ = fmt::format("# {} spots, {} works: made by `luxrig bench nnls --only levels --export FOLDER`.\n", fixtures_,
                       points_);
    out_ += fmt::format("[rig]\nname = \"aisles-{}x{}\"\n\n", fixtures_, points_);
    luminaires();
    building();
    works();
    spots();
    return std::move(out_);
  }

 private:
  [[nodiscard]] double width_m() const { return kAisle_m * walls_ / 2; }

  void luminaires() {
    out_ +=
        "[[luminaire]]\nname = \"narrow\"\nmodel = \"spot\"\nbeam_angle_deg = 26\nfield_angle_deg = 56\nlumens = 700\n"
        "watts = 9\n\n"
        "[[luminaire]]\nname = \"wide\"\nmodel = \"spot\"\nbeam_angle_deg = 44\nfield_angle_deg = 84\nlumens = 1400\n"
        "watts = 17\n\n"
        "[[bus]]\nname = \"tracks\"\ndriver = \"sacn\"\ndestination = \"multicast\"\n\n";
  }

  void box(const std::string& name, double x, double y, double z, double width, double depth, double height,
           double reflectance) {
    out_ += fmt::format(
        "[[scene.object]]\nname = \"{}\"\nposition_m = [{:.3f}, {:.3f}, {:.3f}]\nbox_m = [{:.3f}, {:.3f}, {:.3f}]\n"
        "reflectance = {}\n\n",
        name, x, y, z, width, depth, height, reflectance);
  }

  void building() {
    const double x = length_m_ / 2, y = width_m() / 2, thick = 0.3;
    box("floor", x, y, -thick, length_m_ + 2 * thick, width_m() + 2 * thick, thick, 0.25);
    box("ceiling", x, y, kHeight_m, length_m_ + 2 * thick, width_m() + 2 * thick, thick, 0.7);
    box("west", -thick / 2, y, 0, thick, width_m() + 2 * thick, kHeight_m, 0.75);
    box("east", length_m_ + thick / 2, y, 0, thick, width_m() + 2 * thick, kHeight_m, 0.75);
    box("south", x, -thick / 2, 0, length_m_, thick, kHeight_m, 0.75);
    box("north", x, width_m() + thick / 2, 0, length_m_, thick, kHeight_m, 0.75);
    for (int k = 1; k < walls_ / 2; ++k)
      box(fmt::format("partition {}", k), x, kAisle_m * k, 0, kWorksPerWall * kBetweenWorks_m, 0.2, 3.4, 0.7);
  }

  /// Place of a work, and the direction that its wall faces (along y).
  struct Site {
    double x, y, faces;
  };
  [[nodiscard]] Site place(int wall, double along_m) const {
    const bool south = wall % 2 == 0;
    const int aisle = wall / 2;
    const bool partition = south ? aisle > 0 : aisle + 1 < walls_ / 2;
    const double surface = kAisle_m * (south ? aisle : aisle + 1), half = partition ? 0.1 : 0;
    return {2 + along_m, surface + (south ? half : -half), south ? 1.0 : -1.0};
  }

  void works() {
    for (int i = 0; i < points_; ++i) {
      const Site at = place(i / kWorksPerWall, kBetweenWorks_m * (i % kWorksPerWall + 0.5));
      const bool drawing = i % 5 == 3;
      out_ += fmt::format(
          "[[point]]\nname = \"work {}\"\nposition_m = [{:.4f}, {:.4f}, {:.3f}]\nnormal = [0, {:g}, 0]\ngoal_lx = {}\n",
          i + 1, at.x, at.y + 0.02 * at.faces, 1.55 + 0.1 * (i % 3 - 1), at.faces,
          drawing       ? 50
          : i % 13 == 0 ? 1200
                        : 120 + 20 * (i * 7 % 10));
      if (drawing) out_ += "max_lx = 50\n";
      out_ += "\n";
    }
  }

  void spots() {
    // The same number of spots for each work; the first works get one more each until all are used. The spots of a work
    // hang side by side.
    int made = 0;
    for (int i = 0; i < points_; ++i) {
      const int of_this = fixtures_ / points_ + (i < fixtures_ % points_ ? 1 : 0);
      for (int k = 0; k < of_this; ++k) {
        const double aside = (k + 1.0) / (of_this + 1.0) - 0.5;
        const Site at = place(i / kWorksPerWall, kBetweenWorks_m * (i % kWorksPerWall + 0.5 + 0.8 * aside));
        ++made;
        out_ += fmt::format(
            "[[fixture]]\nname = \"spot {}\"\nluminaire = \"{}\"\nposition_m = [{:.4f}, {:.4f}, {}]\naim = \"work "
            "{}\"\nbus = \"tracks\"\nuniverse = {}\naddress = {}\n\n",
            made, made % 3 == 0 ? "wide" : "narrow", at.x, at.y + kTrackFromWall_m * at.faces, kTrack_z_m, i + 1,
            1 + (made - 1) / 512, 1 + (made - 1) % 512);
      }
    }
  }

  int fixtures_, points_, walls_ = 2;
  double length_m_ = 0;
  std::string out_;
};

}  // namespace

std::string aisles_rig_text(int fixtures, int points) { return Aisles(fixtures, points).text(); }

}  // namespace luxrig
