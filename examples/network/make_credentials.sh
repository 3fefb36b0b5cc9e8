#!/bin/sh
# Makes what tls.json5 and access.json5 ask for, in ./credentials: a certificate authority of our own, the certificate
# of whoever listens, a password for each user, and for each user a Zenoh configuration to connect with.
# Needs OpenSSL 3. Usage: make_credentials.sh [HOST...]: names or addresses of the listening machine beside localhost and 127.0.0.1.
set -eu
umask 077
mkdir credentials || { echo "credentials are here already: remove that folder to make new ones" >&2; exit 1; }
names="DNS:localhost,IP:127.0.0.1"
for host in "$@"; do
    case "$host" in
        *[!0-9.]*) names="$names,DNS:$host" ;;
        *) names="$names,IP:$host" ;;
    esac
done

cd credentials
echo '*' > .gitignore # secrets stay out of repositories
for owner in ca server; do
    openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$owner.key"
done
openssl req -x509 -key ca.key -days 3650 -subj "/CN=hydrotwin authority" -out ca.pem
openssl req -x509 -CA ca.pem -CAkey ca.key -key server.key -days 825 -subj "/CN=hydrotwin" \
    -addext "subjectAltName=$names" -addext "basicConstraints=critical,CA:FALSE" -out server.pem

for user in plant controller recorder operator; do
    password=$(openssl rand -hex 16)
    echo "$user:$password" >> users.txt
    cat > "$user.json5" <<END
// To connect as $user.
{
  transport: {
    link: { tls: { root_ca_certificate: "credentials/ca.pem" } },
    auth: { usrpwd: { user: "$user", password: "$password" } },
  },
}
END
done
echo "made in credentials: keep ca.key at home; server.key and users.txt are for whoever listens, USER.json5 for the user"
