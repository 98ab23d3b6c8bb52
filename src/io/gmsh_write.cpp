// After "MSH file format", version 4.1, of Gmsh's reference manual.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/gmsh_mesh.h"
#include "io/mesh_groups.h"
#include "io/output_file.h"
#include "io/text_output.h"

namespace anatomesh {
namespace {

constexpr std::size_t kMostNameBytes = 120;  // Gmsh reads lines of 128

/// Numbers of the kinds of elements.
struct ElementTypes {
  int triangle = 2, tetrahedron = 4;
};
constexpr ElementTypes kQuadraticTypes = {9, 11};

/// What the points lie in.
struct Box {
  Vec3 least = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
                std::numeric_limits<double>::max()};
  Vec3 most = {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest(),
               std::numeric_limits<double>::lowest()};

  void add(const Vec3& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], point[axis]);
      most[axis] = std::max(most[axis], point[axis]);
    }
  }
};

/// A surface or volume, with the points and elements that belong to it.
struct Entity {
  int dimension = 3;
  Label tag = 0;
  Box box = {};
  std::vector<std::int64_t> boundary = {};  ///< surfaces; with a minus those whose faces look into the volume
  std::vector<VertexId> points = {};
  std::vector<std::size_t> elements = {};  ///< tetrahedra, or faces of the surface
};

/// Surfaces first, then volumes by ascending label: the order of the file.
class GmshModel {
 public:
  explicit GmshModel(const TetMesh& mesh) : mesh_(mesh), groups_(mesh_groups(mesh, kMostNameBytes)) {
    add_surfaces();
    add_volumes();
    place_points();
  }

  std::string text() {
    out_ << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    put_names();
    put_entities();
    put_points();
    put_elements();
    return out_.bytes();
  }

 private:
  void add_surfaces() {
    for (const SurfaceGroup& group : groups_.surfaces) {
      Entity& surface = entities_.emplace_back(Entity{2, group.tag});
      surface.elements.resize(group.between.faces.size());
      for (const TetFace face : group.between.faces) {
        for (const VertexId vertex : nodes_of_face(mesh_, face)) surface.box.add(mesh_.points_mm[vertex]);
      }
    }
  }

  void add_volumes() {
    std::map<Label, std::size_t> place;
    for (const auto& [label, name] : groups_.tissues) {
      place[label] = entities_.size();
      entities_.push_back({3, label});
    }
    for (const SurfaceGroup& group : groups_.surfaces) {
      entities_[place.at(group.between.inside)].boundary.push_back(group.tag);
      if (group.between.outside == 0) continue;
      entities_[place.at(group.between.outside)].boundary.push_back(-std::int64_t{group.tag});
    }
    volume_of_tet_.reserve(mesh_.tets.size());
    for (std::size_t n = 0; n < mesh_.tets.size(); ++n) {
      volume_of_tet_.push_back(place.at(mesh_.labels[n]));
      Entity& volume = entities_[volume_of_tet_.back()];
      volume.elements.push_back(n);
      for (const VertexId vertex : nodes_of_tet(mesh_, n)) volume.box.add(mesh_.points_mm[vertex]);
    }
  }

  /// Each point belongs to the first entity it lies in; those without any tetrahedron to the first volume.
  void place_points() {
    const std::size_t none = entities_.size();
    std::vector<std::size_t> entity_of(mesh_.points_mm.size(), none);
    const auto place = [&](VertexId vertex, std::size_t entity) {
      if (entity_of[vertex] == none) entity_of[vertex] = entity;
    };
    for (std::size_t n = 0; n < groups_.surfaces.size(); ++n) {
      for (const TetFace face : groups_.surfaces[n].between.faces) {
        for (const VertexId vertex : nodes_of_face(mesh_, face)) place(vertex, n);
      }
    }
    for (std::size_t n = 0; n < mesh_.tets.size(); ++n) {
      for (const VertexId vertex : nodes_of_tet(mesh_, n)) place(vertex, volume_of_tet_[n]);
    }
    for (VertexId vertex = 0; vertex < entity_of.size(); ++vertex) {
      const std::size_t entity = entity_of[vertex] == none ? groups_.surfaces.size() : entity_of[vertex];
      entities_[entity].points.push_back(vertex);
    }
  }

  void put_names() {
    out_ << "$PhysicalNames\n" << groups_.surfaces.size() + groups_.tissues.size() << '\n';
    for (const SurfaceGroup& group : groups_.surfaces) out_ << "2 " << group.tag << " \"" << group.name << "\"\n";
    for (const auto& [label, name] : groups_.tissues) out_ << "3 " << label << " \"" << name << "\"\n";
    out_ << "$EndPhysicalNames\n";
  }

  void put_entities() {
    out_ << "$Entities\n0 0 " << groups_.surfaces.size() << ' ' << groups_.tissues.size() << '\n';
    for (const Entity& entity : entities_) {
      out_ << entity.tag << ' ';
      put_point(entity.box.least, ' ');
      put_point(entity.box.most, ' ');
      out_ << "1 " << entity.tag << ' ' << entity.boundary.size();
      for (const std::int64_t surface : entity.boundary) out_ << ' ' << surface;
      out_ << '\n';
    }
    out_ << "$EndEntities\n";
  }

  void put_points() {
    const std::size_t count = mesh_.points_mm.size();
    const auto blocks = std::ranges::count_if(entities_, [](const Entity& entity) { return !entity.points.empty(); });
    out_ << "$Nodes\n" << blocks << ' ' << count << " 1 " << count << '\n';
    for (const Entity& entity : entities_) {
      if (entity.points.empty()) continue;
      out_ << entity.dimension << ' ' << entity.tag << " 0 " << entity.points.size() << '\n';
      for (const VertexId vertex : entity.points) out_ << std::size_t{vertex} + 1 << '\n';
      for (const VertexId vertex : entity.points) put_point(mesh_.points_mm[vertex], '\n');
    }
    out_ << "$EndNodes\n";
  }

  void put_point(const Vec3& point, char end) { out_ << point[0] << ' ' << point[1] << ' ' << point[2] << end; }

  /// The numbers of triangles follow those of the tetrahedra.
  void put_elements() {
    std::size_t number = mesh_.tets.size();
    for (const SurfaceGroup& group : groups_.surfaces) number += group.between.faces.size();
    out_ << "$Elements\n" << entities_.size() << ' ' << number << " 1 " << number << '\n';
    number = mesh_.tets.size();
    const ElementTypes types = is_quadratic(mesh_) ? kQuadraticTypes : ElementTypes();
    for (std::size_t n = 0; n < entities_.size(); ++n) {
      const Entity& entity = entities_[n];
      const bool is_surface = entity.dimension == 2;
      out_ << entity.dimension << ' ' << entity.tag << ' ' << (is_surface ? types.triangle : types.tetrahedron) << ' '
           << entity.elements.size() << '\n';
      if (is_surface) {
        for (const TetFace face : groups_.surfaces[n].between.faces) put_element(++number, nodes_of_face(mesh_, face));
      } else {
        for (const std::size_t tet : entity.elements) put_element(tet + 1, nodes_of_tet(mesh_, tet, kGmshOrder));
      }
    }
    out_ << "$EndElements\n";
  }

  void put_element(std::size_t number, const ElementNodes& nodes) {
    out_ << number;
    for (const VertexId vertex : nodes) out_ << ' ' << std::size_t{vertex} + 1;
    out_ << '\n';
  }

  const TetMesh& mesh_;
  MeshGroups groups_;
  std::vector<Entity> entities_;
  std::vector<std::size_t> volume_of_tet_;
  TextOutput out_;
};

}  // namespace

void write_gmsh(const std::filesystem::path& path, const TetMesh& mesh) {
  if (std::ranges::find(mesh.labels, Label{0}) != mesh.labels.end()) {
    throw InvalidInput("cannot write the mesh " + in_quotes(path) +
                       ": it has the label 0, and Gmsh's groups are numbered from 1; take another format");
  }
  write_whole_file(path, GmshModel(mesh).text());
}

}  // namespace anatomesh
