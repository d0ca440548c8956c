#include "holotrace/trace/materials/sheen.h"

namespace holotrace {
namespace {

constexpr int sheen_steps = 48, sheen_turns = 16;
constexpr int sheen_size = SheenAlbedoTable::size;

// ∫f·share(cosθ_i) dω by midpoints over half of the turns and over √cosθ_i, which is fine at grazing angles.
template <class Share>
float integrate_sheen(double cosine, double roughness, const Share& share) {
  const Vec3 o{std::sqrt(1 - cosine * cosine), 0, cosine};
  double sum = 0;
  for (int j = 0; j < sheen_steps; ++j) {
    const double root = (j + 0.5) / sheen_steps, z = root * root, sine = std::sqrt(1 - z * z);
    double ring = 0;
    for (int k = 0; k < sheen_turns; ++k) {
      const double turn = pi * (k + 0.5) / sheen_turns;
      ring += Sheen::formula(o, {sine * std::cos(turn), sine * std::sin(turn), z}, 1 / (roughness * roughness));
    }
    sum += ring * share(z) * 2 * root;
  }
  return float(sum * 2 * pi / (sheen_steps * sheen_turns));
}

SheenAlbedoTable make_sheen_table() {
  SheenAlbedoTable table;
  for (int row = 0; row < sheen_size; ++row) {
    const double roughness = std::fmax(Sheen::least_roughness, double(row) / (sheen_size - 1));
    auto &whole = table.whole[size_t(row)], &kept = table.kept[size_t(row)];
    const auto cosine_of = [](int column) {
      const double root = std::fmax(0.01, double(column) / (sheen_size - 1));
      return root * root;
    };
    for (int column = 0; column < sheen_size; ++column)
      whole[size_t(column)] = integrate_sheen(cosine_of(column), roughness, [](double) { return 1.0; });
    kept = whole;
    if (*std::max_element(whole.begin(), whole.end()) <= 1) continue;
    const auto at = [&](double z) {
      const double x = std::sqrt(z) * (sheen_size - 1);
      const int column = std::clamp(int(x), 0, sheen_size - 2);
      return whole[size_t(column)] + (x - column) * (whole[size_t(column) + 1] - whole[size_t(column)]);
    };
    for (int column = 0; column < sheen_size; ++column) {
      const double own = whole[size_t(column)];
      kept[size_t(column)] = integrate_sheen(cosine_of(column), roughness, [&](double z) {
        return 1 / std::max({1.0, own, at(z)});
      });
    }
  }
  return table;
}

}  // namespace

const SheenAlbedoTable& sheen_albedo_table() {
  static const SheenAlbedoTable table = make_sheen_table();
  return table;
}

}  // namespace holotrace
