// The block [0, 1] x [0, 1] x [0, 0.5], of tetrahedra. Boundaries: top, foot, sides.
SetFactory("OpenCASCADE");
DefineConstant[ size = 0.3 ];
Box(1) = {0, 0, 0, 1, 1, 0.5};
eps = 1e-6;
top() = Surface In BoundingBox{-eps, -eps, 0.5 - eps, 1 + eps, 1 + eps, 0.5 + eps};
foot() = Surface In BoundingBox{-eps, -eps, -eps, 1 + eps, 1 + eps, eps};
sides() = Surface{:};
sides() -= top();
sides() -= foot();
Physical Surface("top") = top();
Physical Surface("foot") = foot();
Physical Surface("sides") = sides();
Physical Volume("block") = {1};
Mesh.MeshSizeMax = size;
Mesh.MeshSizeMin = size;
