"""Certificates made for one test run, with the openssl command."""
import os
import ssl
import subprocess
import time

CONFIG = """[ca]
default_ca = ours
[ours]
database = {folder}/index
serial = {folder}/serial
new_certs_dir = {folder}
default_md = sha256
policy = any
unique_subject = no
x509_extensions = leaf
[any]
commonName = optional
[leaf]
basicConstraints = critical,CA:false
subjectAltName = IP:127.0.0.1
"""


def openssl(*arguments):
    subprocess.run(["openssl", *arguments], check=True, capture_output=True, timeout=60)


class Authority:
    def __init__(self, folder):
        self.folder = folder
        os.makedirs(folder)
        for name, text in (("config", CONFIG.format(folder=folder)), ("index", ""),
                           ("serial", "01\n")):
            with open(os.path.join(folder, name), "w", encoding="ascii") as file:
                file.write(text)
        self.cert = self.path("ca.pem")
        openssl("req", "-x509", *self.new_key("ca"), "-out", self.cert, "-subj", "/CN=authority",
                "-days", "2")

    def path(self, name):
        return os.path.join(self.folder, name)

    def new_key(self, name):
        return ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout",
                self.path(name + ".key"))

    def issue(self, name, subject=None, seconds=86400):
        """Issues a certificate that is valid for so many seconds from now. Returns (certificate, key)."""
        def stamp(offset):
            return time.strftime("%Y%m%d%H%M%SZ", time.gmtime(time.time() + offset))

        cert, key = self.path(name + ".pem"), self.path(name + ".key")
        openssl("req", *self.new_key(name), "-out", self.path(name + ".csr"), "-subj",
                subject or f"/CN={name}")
        openssl("ca", "-batch", "-notext", "-config", self.path("config"), "-cert", self.cert,
                "-keyfile", self.path("ca.key"), "-in", self.path(name + ".csr"), "-out", cert,
                "-startdate", stamp(-7 * 86400), "-enddate", stamp(seconds))
        os.chmod(key, 0o600)
        return cert, key

    def revoke(self, *names, due=172800):
        """Writes the list of all revoked certificates, and returns its path. The list expires after so many
        seconds."""
        by = ("-config", self.path("config"), "-cert", self.cert, "-keyfile", self.path("ca.key"))
        for name in names:
            openssl("ca", *by, "-revoke", self.path(name + ".pem"))
        openssl("ca", *by, "-gencrl", "-crlsec", str(due), "-out", self.path("crl.pem"))
        return self.path("crl.pem")


def context(authority, pair=None):
    """The ssl.SSLContext of a client: the authorities that it trusts, and the certificate that it presents."""
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    tls.load_verify_locations(authority.cert)
    if pair:
        tls.load_cert_chain(*pair)
    return tls
