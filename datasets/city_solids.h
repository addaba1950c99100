#pragma once
// A city as CityJSON text sequences (.city.jsonl): buildings as closed solids, a line each.

#include <filesystem>
#include <memory>

#include "datasets/city_file.h"
#include "layout/file_io.h"

namespace promenade {

/// Coordinates are whole millimetres, so that walls which meet still do. Buildings are solids of level of detail 1.3,
/// whatever else stands once is a MultiSurface; of cars and trees there are none.
class CitySolids : public CityFile {
 public:
  static Result<std::unique_ptr<CityFile>> create(const std::filesystem::path& path);
  Status add(const CityBlock& block, uint32_t x, uint32_t y, const std::vector<EncodedFacade>& facades,
             PropLibrary& props, CityFigures& figures) override;
  Status add_traffic(const std::vector<MovingCar>& cars, PropLibrary& props, CityFigures& figures) override;
  Status finish() override { return file_.commit(); }

 private:
  explicit CitySolids(AtomicFile file) : file_(std::move(file)) {}
  Status write_line(const std::string& line);

  AtomicFile file_;
};

/// Whether a name asks for one.
bool is_city_solids(const std::filesystem::path& output);

}  // namespace promenade
