// Two unit vectors that form a right-handed basis with the unit normal n (Duff et al. 2017, "Building an Orthonormal
// Basis, Revisited", JCGT 6(1)).
void tangent_basis(vec3 n, out vec3 e1, out vec3 e2)
{
    float sign = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (sign + n.z);
    float b = n.x * n.y * a;
    e1 = vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    e2 = vec3(b, sign + n.y * n.y * a, -n.y);
}
