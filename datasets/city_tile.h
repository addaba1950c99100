#pragma once
// One file of the city: blocks come in, a .glb goes out.

#include <filesystem>
#include <map>
#include <memory>

#include "datasets/city_file.h"
#include "datasets/glb_writer.h"

namespace promenade {

/// A .glb.
class CityTile : public CityFile {
 public:
  static Result<std::unique_ptr<CityFile>> create(const std::filesystem::path& path);
  Status add(const CityBlock& block, uint32_t x, uint32_t y, const std::vector<EncodedFacade>& facades,
             PropLibrary& props, CityFigures& figures) override;
  Status add_traffic(const std::vector<MovingCar>& cars, PropLibrary& props, CityFigures& figures) override;
  Status finish() override { return writer_.finish(); }

 private:
  explicit CityTile(GlbWriter writer) : writer_(std::move(writer)) {}
  Status add_object(const UniqueObject& object, const EncodedFacade& facade, CityFigures& figures);
  /// Counts an instance of the mesh, too.
  Result<uint32_t> mesh_of(const PropKind& kind, PropLibrary& props, CityFigures& figures);
  Status add_prop(const PropInstance& prop, const std::string& name, PropLibrary& props, CityFigures& figures);

  GlbWriter writer_;
  std::map<PropKind, uint32_t> mesh_of_;
};

}  // namespace promenade
