#include "core/scene/ply_importer.h"

#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <memory>
#include <utility>

namespace luxrig {
namespace {

class PlyImporter final : public Assimp::BaseImporter {
 public:
  explicit PlyImporter(PlyMesh mesh) : mesh_(std::move(mesh)) {}

  bool CanRead(const std::string&, Assimp::IOSystem*, bool) const override { return true; }
  const aiImporterDesc* GetInfo() const override {
    static const aiImporterDesc description = [] {
      aiImporterDesc one{};
      one.mName = "Luxrig PLY";
      one.mAuthor = one.mMaintainer = one.mComments = "";
      one.mFileExtensions = "ply";
      return one;
    }();
    return &description;
  }

 protected:
  void InternReadFile(const std::string&, aiScene* scene, Assimp::IOSystem*) override {
    auto mesh = std::make_unique<aiMesh>();
    mesh->mVertices = new aiVector3D[mesh_.vertices.size()];
    for (const Vec3f& v : mesh_.vertices) mesh->mVertices[mesh->mNumVertices++].Set(v.x(), v.y(), v.z());
    mesh->mFaces = new aiFace[mesh_.corner_counts.size()];
    const std::uint32_t* corner = mesh_.corners.data();
    for (const std::uint32_t count : mesh_.corner_counts) {
      aiFace& face = mesh->mFaces[mesh->mNumFaces++];
      face.mIndices = new unsigned[count];
      face.mNumIndices = count;
      std::copy(corner, corner + count, face.mIndices);
      corner += count;
    }
    mesh_ = PlyMesh();
    scene->mMeshes = new aiMesh* [1] { mesh.release() };
    scene->mNumMeshes = 1;
    scene->mRootNode = new aiNode();
    scene->mRootNode->mMeshes = new unsigned[1]{0};
    scene->mRootNode->mNumMeshes = 1;
  }

 private:
  PlyMesh mesh_;
};

}  // namespace

void give_ply(Assimp::Importer& importer, PlyMesh mesh) {
  while (importer.GetImporterCount() > 0) {
    Assimp::BaseImporter* const reader = importer.GetImporter(importer.GetImporterCount() - 1);
    importer.UnregisterLoader(reader);
    delete reader;  // unregistering hands it back
  }
  importer.RegisterLoader(new PlyImporter(std::move(mesh)));  // owns it from here
}

}  // namespace luxrig
