// A strip of length 1 and width 0.1 in squares, each of two triangles.
DefineConstant[edges = 40];
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 0.1, 0};
Point(4) = {0, 0.1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = edges + 1;
Transfinite Curve {2, 4} = edges / 10 + 1;
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Physical Curve("held") = {2};
Physical Surface("bed") = {1};
